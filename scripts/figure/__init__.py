"""How the committed figures are made anew: console blocks of pages, tables between markers, pictures. `scripts/figures` has the list."""
