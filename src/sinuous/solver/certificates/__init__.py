"""What is proved of motions between configurations, also where obstacles move, and how far the tip leaves a line."""
