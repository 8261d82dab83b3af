"""Which answers are known before anyone solves: problems with optima from elsewhere."""

from skyknot.bank.base import Reference, line
from skyknot.bank.catalogue import CATALOGUE
from skyknot.bank.integrators import minimum_energy, minimum_time
from skyknot.bank.judgement import Judgement, judged
from skyknot.bank.rockets_and_gliders import cart_pole
from skyknot.bank.rotorcraft import quadrotor_transfer
from skyknot.bank.shortest_times import brachistochrone, steering
from skyknot.bank.smooth_optima import garg, hager, regulator, scalar_regulator
from skyknot.bank.state_limits import bryson_denham, van_der_pol

__all__ = [
    "CATALOGUE",
    "Judgement",
    "Reference",
    "brachistochrone",
    "bryson_denham",
    "cart_pole",
    "garg",
    "hager",
    "judged",
    "line",
    "minimum_energy",
    "minimum_time",
    "quadrotor_transfer",
    "regulator",
    "scalar_regulator",
    "steering",
    "van_der_pol",
]
