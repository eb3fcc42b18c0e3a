"use strict";
// Unpacks the profiler's program (gzip in base64) and runs it; the script element holds the data.
(async () => {
  if (typeof DecompressionStream === "undefined") return;
  const unpacked = (id) => {
    const text = document.getElementById(id).textContent;
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).json();
  };
  const [data, { style, code }] = await Promise.all(["explore-data", "explore-program"].map(unpacked));
  for (const [name, text] of [["style", style], ["script", code]]) {
    const part = document.createElement(name);
    part.textContent = text;
    if (name === "script") part.study = data;
    document.head.append(part);
  }
})();
