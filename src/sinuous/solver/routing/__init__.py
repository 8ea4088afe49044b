"""Starts from routes: searched for, laid or grown along, and drawn to the targets."""
