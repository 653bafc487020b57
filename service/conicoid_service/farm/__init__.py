"""Jobs rendered by workers on other machines: Celery on RabbitMQ, with the job store as the truth.

`queues` names what both sides share. In the API `steward` keeps the queues filled through `broker`. In a worker
`worker` runs Celery, whose children each have a `station`, and `watch` answers probes; `once` renders a single unit.
"""
