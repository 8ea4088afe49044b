"""The answer: status, reasons, verification."""
