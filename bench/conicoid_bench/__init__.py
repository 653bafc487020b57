"""Benchmarks: `conicoid bench error` measures run time against error, in one run, beside honest baselines.

scenes.py (what) -> engine.py, opencl.py, vectorised.py, mitsuba.py (who) -> measure.py (how long, how wrong)
      -> results.py (JSON), table.py, figure.py (for people)
"""
