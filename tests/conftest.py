"""Settings for every test."""

from hypothesis import HealthCheck, settings

# The same examples on every run, and no verdict by the clock: a slow machine is not a defect.
settings.register_profile("conicoid", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("conicoid")
