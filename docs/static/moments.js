for (const figure of document.querySelectorAll("figure.moments")) {
  const moments = JSON.parse(figure.dataset.moments), slider = figure.querySelector("input");
  const blocks = figure.querySelectorAll("polygon"), [far, load] = [0, 1].map(k => Math.max(...moments.map(m => m.at[k])));
  const place = ([x, y]) => [16 + 292 * x / far, 116 - 104 * Math.max(y, 0) / load];
  figure.querySelector("polyline").setAttribute("points", moments.map(m => place(m.at)).join(" "));
  const show = () => {
    const { load, far, at, motion } = moments[slider.value], [cx, cy] = place(at), dot = figure.querySelector("circle");
    blocks.forEach((block, i) => {
      const [u, v, turn] = motion[i], { x, y } = block.dataset;
      block.setAttribute("transform", `translate(${u} ${-v}) rotate(${-turn * 180 / Math.PI} ${x} ${y})`);
    });
    dot.setAttribute("cx", cx), dot.setAttribute("cy", cy);
    figure.querySelector("output").value = `λ = ${load}, largest displacement ${far} mm`;
  };
  slider.addEventListener("input", show), show();
}
