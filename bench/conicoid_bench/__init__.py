"""Benchmarks: `conicoid bench error`, `speed` and `service`, each in one run beside honest baselines.

workloads.py, scenes.py (what) -> truth.py (what is right)
engine.py, opencl.py, vectorised.py, mitsuba_shapes.py, compiled.py, embree.py (who)
error: error.py -> measure.py (how long, how wrong) -> files.py: texts.py, table.py, figure.py (for people)
speed, service: speed/ and service/, which say so themselves
"""
