"""Optimal trajectories of multirotor and urban-air-mobility vehicles."""
