"""The long stress run: `make stress` checks millions of pixels against the exact image and writes a report."""
