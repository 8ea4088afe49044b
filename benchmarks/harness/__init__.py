"""The harness: pieces of work into a journal, findings from it, one report, one comparison, one exit code."""
