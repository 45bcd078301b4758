for (const group of document.querySelectorAll(".moments")) {
  const slider = group.querySelector("input"), shown = [];
  const show = () => shown.forEach(place => place(slider.value / slider.max));
  Promise.all([...group.querySelectorAll("[data-motion]")].map(async figure => {
    const { of, motion, unit, said, colours } = figure.dataset, words = said.split("|"), count = words.length;
    const packed = Uint8Array.from(atob(motion), letter => letter.charCodeAt(0));
    const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const moved = new Int8Array(await new Response(plain).arrayBuffer()), [long, turn] = unit.split(" ").map(Number);
    const drawing = figure.querySelector("svg"), n = moved.length / (3 * count), way = figure.querySelector("polyline").points;
    const blocks = document.getElementById(of).getAttribute("d").split("M").slice(1).map(part => {
      const block = document.createElementNS(drawing.namespaceURI, "path");
      block.setAttribute("class", "block"), block.setAttribute("d", "M" + part), drawing.append(block);
      return [block, ...part.match(/-?\d+/g).slice(0, 2).map(Number)];
    });
    const [rest, fast] = colours.split(" ").map(name => [1, 3, 5].map(k => parseInt(name.slice(k, k + 2), 16)));
    shown.push(share => {
      const k = Math.round(share * (count - 1)), dot = figure.querySelector("circle"), { x, y } = way.getItem(k);
      blocks.forEach(([block, x, y], i) => {
        const [u, v, w] = [0, 1, 2].map(part => (part < 2 ? long : turn) * moved[(part * count + k) * n + i]);
        block.setAttribute("transform", `matrix(1 ${-w} ${w} 1 ${u - w * y} ${v + w * x})`);
        const far = Math.min(1, Math.hypot(u, v) / (127 * long));
        block.setAttribute("fill", `rgb(${rest.map((from, c) => Math.round(from + far * (fast[c] - from)))})`);
      });
      dot.setAttribute("cx", x), dot.setAttribute("cy", y);
      figure.querySelector("output").value = words[k];
    });
    shown.at(-1)(slider.value / slider.max);
  })).then(() => { slider.addEventListener("input", show), group.hidden = false; });
}
