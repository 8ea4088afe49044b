"""How nouns are written down: as plain values, and these as YAML or JSON. `sinuous.files` reads them."""
