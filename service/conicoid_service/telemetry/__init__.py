"""What an operator can see of the service: metrics, logs, traces."""
