"""Benchmarks: `conicoid bench error` and `conicoid bench speed`, each in one run beside honest baselines.

workloads.py, scenes.py (what) -> truth.py (what is right)
engine.py, opencl.py, vectorised.py, mitsuba_shapes.py, compiled.py, embree.py (who)
error: error.py -> measure.py (how long, how wrong) -> files.py: JSON, table.py, figure.py (for people)
speed: speed/, which says so itself
"""
