"""Who may ask, how much at once, from which web pages, and how slowly: what stands before the routes."""
