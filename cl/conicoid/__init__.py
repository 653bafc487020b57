"""Conicoid's engine: quadric scenes in, depth and normal planes out."""

from importlib.metadata import version

__version__ = version("conicoid")
