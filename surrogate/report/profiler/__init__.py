"""The live profiler of the report: surrogates that answer in the browser.

`payload.payload` says what goes into the page, and `javascript/` holds the modules that run
there; start at `engine.js` (what is worked out) and `main.js` (what is shown).
"""
