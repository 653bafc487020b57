"""The migrations, one after the other; each names the one before."""
