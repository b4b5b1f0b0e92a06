"""The report generator of graze: reads the store of one run, writes a page, tables and figures."""
