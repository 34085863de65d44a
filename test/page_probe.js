// Looks at a page from inside: returns what a reader could not read. Arguments: least contrast of text, of a picture.
const [leastOfText, leastOfPicture] = arguments;
document.querySelectorAll("details").forEach((part) => { part.open = true; });

const parse = (text) => {
  const [red, green, blue, alpha = 1] = (text.match(/[\d.]+/g) || [0, 0, 0, 0]).map(Number);
  return [red, green, blue, alpha];
};
const over = (top, bottom, alpha) => [0, 1, 2].map((k) => alpha * top[k] + (1 - alpha) * bottom[k]);
const luminance = (colour) => {
  const [red, green, blue] = colour.map((value) => {
    const share = value / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
};
const contrast = (one, other) => {
  const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
};
const ancestors = (node) => { const found = []; for (; node; node = node.parentElement) found.push(node); return found; };
const background = (node) => ancestors(node).reverse().reduce((below, each) => {
  const own = parse(getComputedStyle(each).backgroundColor);
  return over(own, below, own[3]);
}, [255, 255, 255]);
const opacity = (node) => ancestors(node).reduce((all, each) => all * Number(getComputedStyle(each).opacity), 1);
const seen = (colour, node, alpha) => over(colour, background(node), colour[3] * alpha * opacity(node));

const faint = [];
const words = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
let texts = 0;
while (words.nextNode()) {
  const node = words.currentNode.parentElement;
  const text = words.currentNode.textContent.trim();
  if (!text || node.closest("style, script") || !node.getClientRects().length) continue;
  texts += 1;
  const style = getComputedStyle(node);
  const inSvg = node.closest("svg");
  const colour = parse(inSvg ? style.fill : style.color);
  const ratio = contrast(seen(colour, node, inSvg ? Number(style.fillOpacity) : 1), background(node));
  if (ratio < leastOfText) faint.push(`${text.slice(0, 40)}: ${ratio.toFixed(2)}`);
}

const invisible = [];
document.querySelectorAll("svg, img, canvas").forEach((picture) => {
  const box = picture.getBoundingClientRect();
  const name = picture.getAttribute("aria-label") || picture.getAttribute("alt") || "";
  const drawn = [...picture.querySelectorAll("path:not(defs path), use")].filter((path) => {
    const style = getComputedStyle(path);
    return [["fill", style.fillOpacity], ["stroke", style.strokeOpacity]].some(([kind, alpha]) =>
      style[kind] !== "none" &&
      contrast(seen(parse(style[kind]), path, Number(alpha)), background(path)) >= leastOfPicture);
  });
  const unnamed = !name.trim() ? " has no name" : "";
  const small = box.width < 200 || box.height < 100 ? ` is ${box.width} x ${box.height}` : "";
  const empty = picture.tagName === "svg" && !drawn.length ? " shows nothing" : "";
  const outside = box.left < -0.5 || box.right > document.documentElement.clientWidth + 0.5 ? " is cut off" : "";
  if (unnamed || small || empty || outside) invisible.push(`${name}${unnamed}${small}${empty}${outside}`);
});

return {
  faint, invisible, texts,
  pictures: document.querySelectorAll("svg, img, canvas").length,
  headings: [...document.querySelectorAll("h1, h2, h3, h4, h5, h6")].map((each) => Number(each.tagName[1])),
  unnamed: [...document.querySelectorAll("h1, h2, h3, h4, h5, h6")].filter((each) => !each.textContent.trim()).length,
  scroll: document.documentElement.scrollWidth, width: document.documentElement.clientWidth,
  dark: matchMedia("(prefers-color-scheme: dark)").matches,
  page: luminance(background(document.body)),
};
