"""The tables of the job store, as the newest migration leaves them; `migrations/` has the way there."""

from typing import Final

from sqlalchemy import BigInteger, Column, ForeignKey, Index, Integer, MetaData, String, Table, Text, UniqueConstraint

# Names of constraints, so that a migration can name them on every database.
metadata: Final = MetaData(
    naming_convention={
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_name)s",
        "pk": "pk_%(table_name)s",
    }
)

# Times are milliseconds since 1970, UTC.
jobs: Final = Table(
    "jobs",
    metadata,
    Column("id", String(32), primary_key=True),  # sorts by time of creation
    Column("owner", String(64), nullable=False),
    Column("state", String(9), nullable=False),
    Column("created_ms", BigInteger, nullable=False),
    Column("started_ms", BigInteger),
    Column("finished_ms", BigInteger),
    Column("expires_ms", BigInteger),
    Column("frames_total", Integer, nullable=False),
    Column("frames_done", Integer, nullable=False, default=0),
    Column("frames_failed", Integer, nullable=False, default=0),
    Column("quadrics_hash", String(64), nullable=False),
    Column("idempotency_key", String(255)),
    Column("digest", String(64), nullable=False),
    Column("priority", Integer, nullable=False, default=0),  # see `records.PRIORITIES`
    UniqueConstraint("owner", "idempotency_key"),
    Index(None, "owner", "id"),
    Index(None, "state", "owner", "id"),
    Index(None, "quadrics_hash"),
)

# What can be rendered at a time: a frame, or a band of a large one. Band 0 stands for the whole frame.
frames: Final = Table(
    "frames",
    metadata,
    Column("job_id", ForeignKey(jobs.c.id, ondelete="CASCADE"), primary_key=True),
    Column("number", Integer, primary_key=True),
    Column("band", Integer, primary_key=True, default=0),
    Column("bands", Integer, nullable=False, default=0),  # into which the frame is cut; 0: it is rendered whole
    Column("bands_left", Integer, nullable=False, default=0),  # that it waits for before it is joined; of band 0
    Column("state", String(9), nullable=False),
    Column("view", Text, nullable=False),  # camera and output, a line of JSON
    Column("scene_hash", String(64), nullable=False),
    Column("attempts", Integer, nullable=False, default=0),
    Column("not_before_ms", BigInteger, nullable=False, default=0),
    Column("sent_ms", BigInteger),  # to the broker of a farm, when it was last sent
    Column("taken_ms", BigInteger),  # by a worker of a farm, which says so again and again
    Column("holder", String(32)),  # the server that renders it
    Column("ended_as", Integer),  # the n-th frame of its job to end, from 1
    Column("tag", String(64)),  # of its image
    Column("error_code", String(64)),
    Column("error_detail", Text),
    Index(None, "job_id", "state", "number"),
    Index(None, "job_id", "ended_as"),
    Index(None, "state", "holder"),
    Index(None, "state", "sent_ms"),
    Index(None, "tag"),
)

images: Final = Table(
    "images",
    metadata,
    Column("tag", String(64), primary_key=True),
    Column("bytes", BigInteger, nullable=False),
    Column("sha256", String(64), nullable=False),
    Column("scene_hash", String(64), nullable=False),
    Column("refined", Integer, nullable=False),
    Column("settled", Integer, nullable=False),
    Column("used_ms", BigInteger, nullable=False),
    Index(None, "used_ms"),
)

# One row: what the object store is marked with.
identity: Final = Table("identity", metadata, Column("name", String(32), primary_key=True))

# Quadrics that were kept for later requests.
scenes: Final = Table(
    "scenes",
    metadata,
    Column("id", String(64), primary_key=True),  # the quadrics' hash, which also names their file
    Column("quadrics", Integer, nullable=False),
    Column("bytes", BigInteger, nullable=False),
    Column("used_ms", BigInteger, nullable=False),
    Index(None, "used_ms"),
)
