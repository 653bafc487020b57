"""Alembic's entry: runs migrations on the connection that `database.Database` gives."""

from alembic import context

context.configure(connection=context.config.attributes["connection"], transactional_ddl=True)
context.run_migrations()
