"""Tests of Conicoid; a package, so that the oracle and the scene generators are imported by name."""
