"""Priorities of jobs, bands of frames, what a farm has to know of both; kept scenes."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Add to the tables of 0001."""
    op.add_column("jobs", sa.Column("priority", sa.Integer(), nullable=False, server_default="0"))
    with op.batch_alter_table("frames") as frames:
        for name in ("band", "bands", "bands_left"):
            frames.add_column(sa.Column(name, sa.Integer(), nullable=False, server_default="0"))
        for name in ("sent_ms", "taken_ms"):
            frames.add_column(sa.Column(name, sa.BigInteger()))
        frames.drop_constraint("pk_frames", type_="primary")
        frames.create_primary_key("pk_frames", ["job_id", "number", "band"])
        frames.create_index("ix_frames_state_sent_ms", ["state", "sent_ms"])
    op.create_table(
        "identity",
        sa.Column("name", sa.String(32), nullable=False),
        sa.PrimaryKeyConstraint("name", name="pk_identity"),
    )
    op.create_table(
        "scenes",
        sa.Column("id", sa.String(64), nullable=False),
        sa.Column("quadrics", sa.Integer(), nullable=False),
        sa.Column("bytes", sa.BigInteger(), nullable=False),
        sa.Column("used_ms", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_scenes"),
    )
    op.create_index("ix_scenes_used_ms", "scenes", ["used_ms"])
