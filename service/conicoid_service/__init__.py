"""Conicoid's HTTP application and the render process it supervises."""
