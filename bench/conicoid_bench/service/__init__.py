"""`conicoid bench service`: what is slow around the ray-casting, HTTP to HTTP, on real processes.

server.py (a service of its own) -> encoding.py (OpenEXR alone) -> run.py (laps) -> table.py -> files.py
"""
