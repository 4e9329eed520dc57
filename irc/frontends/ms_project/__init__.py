"""Projects of MS Project as XML: in, a task; out, a task or a schedule as such a project."""
