"""What people look at: drawings of walls and mechanisms, charts, and files for ParaView."""
