"""Conicoid's HTTP client and the `conicoid` command."""
