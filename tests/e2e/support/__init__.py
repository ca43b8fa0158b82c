"""What the end-to-end tests share: a real daemon, a client, scene bytes, image readers."""
