"""What flies: equations of motion, vehicles, and how rotors make a wrench."""

from skyknot.models.allocation import Allocation
from skyknot.models.base import Model
from skyknot.models.flatness import lift
from skyknot.models.limits import HoverPower, Limits, WrenchLimits
from skyknot.models.quadrotor import Quadrotor
from skyknot.models.reduced_path import lifted_path
from skyknot.models.rotor_quadrotor import RotorQuadrotor
from skyknot.models.translational_yaw import TranslationalYaw
from skyknot.models.vehicle import Vehicle

__all__ = [
    "Allocation",
    "HoverPower",
    "Limits",
    "Model",
    "Quadrotor",
    "RotorQuadrotor",
    "TranslationalYaw",
    "Vehicle",
    "WrenchLimits",
    "lift",
    "lifted_path",
]
