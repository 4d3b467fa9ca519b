"""Forces and dynamics: reactions group by group, friction, power, balance, simulation."""
