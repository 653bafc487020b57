"""`conicoid bench speed`: times of Conicoid and its peers on the same scenes in one run, and how they grow.

scenes.py, growth.py (what) -> contenders.py, floor.py (who) -> race.py (in turn, how long, how wrong)
      -> run.py (all of it) -> table.py, figure.py (for people) -> files.py
"""
