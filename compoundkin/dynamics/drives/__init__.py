"""What drivers do over a cycle: flywheels, figures of motors, harmonics, equilibrium without them."""
