"""Starts from routes: searched for, fitted to them or grown along them, and drawn to the targets."""
