// The viewer of a report's page, which compares its images.
//
// It holds radiance. Exposure is a factor on it, and only what is drawn goes through sRGB's transfer function
// (IEC 61966-2-1). The canvas has the image's own pixels and is enlarged by the browser in whole steps without
// smoothing. How images are stored is told at the top of viewer.py.

function halfToNumber(bits) {
    const sign = bits & 0x8000 ? -1 : 1;
    const exponent = bits >> 10 & 31;
    const mantissa = bits & 1023;
    if (exponent === 31) return mantissa ? NaN : sign * Infinity;
    return sign * (exponent ? (1024 + mantissa) * 2 ** (exponent - 25) : mantissa * 2 ** -24);
}

const halves = Float32Array.from({length: 65536}, (_, bits) => halfToNumber(bits));

// Radiance of a layer, three numbers a pixel.
async function decode(pixelsInBase64, scene) {
    const packed = Uint8Array.from(atob(pixelsInBase64), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const pixels = scene.width * scene.height;
    const radiance = new Float32Array(3 * pixels);
    for (let channel = 0; channel < 3; ++channel)
        for (let pixel = 0; pixel < pixels; ++pixel) {
            const place = channel * pixels + pixel;
            radiance[3 * pixel + channel] = halves[bytes[place] | bytes[3 * pixels + place] << 8] / scene.scale;
        }
    return radiance;
}

// Radiance of a layer of an image, or the picture: the sum of its layers where it is not given. NaN for what it does not have.
async function radianceOf(shot, layer, scene) {
    const given = shot.layers;
    const names = layer in given ? [layer] : layer === "picture" ? Object.keys(given) : [];
    if (!names.length) return new Float32Array(3 * scene.width * scene.height).fill(NaN);
    scene.decoded ??= [];
    const parts = await Promise.all(names.map((name) => scene.decoded[given[name]] ??=
        decode(scene.pixels[given[name]], scene)));
    return parts.length === 1 ? parts[0] : parts[0].map((value, place) =>
        parts.slice(1).reduce((sum, part) => sum + part[place], value));
}

// What a screen is sent for a linear value, from 0 to 255.
function toSrgb(value) {
    const clipped = Math.min(Math.max(value, 0), 1);
    return 255 * (clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * clipped ** (1 / 2.4) - 0.055);
}

function threeDigits(value) {
    return value === 0 || !Number.isFinite(value) ? String(value) : value.toPrecision(3).replace("-", "−");
}

const data = JSON.parse(element("data").textContent);
const picture = element("picture");    // null where the page has no images
const canvas = picture?.querySelector("canvas");
const context = canvas?.getContext("2d", {willReadFrequently: true});
const slider = (id) => Number(element(id).value);
const mode = () => document.querySelector("input[name=mode]:checked").value;

let scene = null;
let a = null;           // radiance of the images in the slots
let b = null;
let flipped = false;    // whether flip mode shows B
let place = null;       // [x, y] of the pixel whose values are shown

const chosen = (slot) => scene.images[element(`image-${slot}`).value];
const shotOf = (slot) => chosen(slot).seeds[element(`seed-${slot}`).value];
const layer = () => element("layer").value;
const exposure = () => scene.exposure * 2 ** slider("exposure");
const differenceScale = () => exposure() * 2 ** slider("gain");

function isNotNumber(image, index) {
    return Number.isNaN(image[index]) || Number.isNaN(image[index + 1]) || Number.isNaN(image[index + 2]);
}

function drawMagenta(output, pixel) {
    output[4 * pixel] = output[4 * pixel + 2] = output[4 * pixel + 3] = 255;
}

// A left of the divider, B right of it.
function drawImages(output, divider) {
    const factor = exposure();
    for (let pixel = 0; pixel < scene.width * scene.height; ++pixel) {
        const image = pixel % scene.width < divider ? a : b;
        if (isNotNumber(image, 3 * pixel)) {
            drawMagenta(output, pixel);
            continue;
        }
        for (let channel = 0; channel < 3; ++channel)
            output[4 * pixel + channel] = toSrgb(image[3 * pixel + channel] * factor);
        output[4 * pixel + 3] = 255;
    }
}

function drawDifference(output) {
    const factor = differenceScale();
    const absolute = element("map").value === "absolute";
    const colours = data.differenceColours;
    const middle = (colours.length - 1) / 2;
    const difference = new Float64Array(3);
    for (let pixel = 0; pixel < scene.width * scene.height; ++pixel) {
        for (let channel = 0; channel < 3; ++channel)
            difference[channel] = (a[3 * pixel + channel] - b[3 * pixel + channel]) * factor;
        const mean = (difference[0] + difference[1] + difference[2]) / 3;
        if (Number.isNaN(mean)) {
            drawMagenta(output, pixel);
            continue;
        }
        const colour = colours[Math.round(middle * (1 + Math.min(Math.max(mean, -1), 1)))];
        for (let channel = 0; channel < 3; ++channel)
            output[4 * pixel + channel] = absolute ? toSrgb(Math.abs(difference[channel])) : colour[channel];
        output[4 * pixel + 3] = 255;
    }
}

function draw() {
    if (!a || !b) return;
    const output = context.createImageData(scene.width, scene.height);
    const now = mode();
    if (now === "difference") drawDifference(output.data);
    else drawImages(output.data, now === "wipe" ? slider("divider-place") : flipped ? 0 : scene.width);
    context.putImageData(output, 0, 0);
    describe(now);
}

function describe(now) {
    const zoom = slider("zoom");
    canvas.style.width = `${zoom * scene.width}px`;
    canvas.style.height = `${zoom * scene.height}px`;
    for (const shown of ["flip", "wipe", "difference"])
        for (const part of document.querySelectorAll(`.of-${shown}`)) part.hidden = shown !== now;

    const divider = element("divider");
    divider.hidden = now !== "wipe";
    divider.style.left = `${zoom * slider("divider-place")}px`;
    element("left-tag").textContent = now === "difference" ? "" : now === "flip" && flipped ? "B" : "A";
    element("right-tag").textContent = now === "wipe" ? "B" : "";
    element("flip").textContent = flipped ? "Flip to A" : "Flip to B";

    const named = (slot) => {
        const {name, seeds} = chosen(slot);
        const {seed, captions, layers} = shotOf(slot);
        const caption = captions[layer() === "picture" ? "total" : layer()];
        const has = layer() === "picture" || layer() in layers;
        return `${slot.toUpperCase()}: ${name}${seeds.length > 1 ? `, seed ${seed}` : ""}` +
            (layer() === "picture" ? "" : has ? `, ${layer()}` : `: has no layer ${layer()}`) +
            (caption ? ` (${caption})` : "");
    };
    element("legend").textContent = now === "flip" ? named(flipped ? "b" : "a") : `${named("a")}\n${named("b")}`;

    const stops = slider("exposure");
    setOutput("exposure", `${stops < 0 ? "−" : "+"}${Math.abs(stops).toFixed(2)} stops, white is ` +
              threeDigits(1 / exposure()));
    setOutput("gain", `× ${2 ** slider("gain")}`);
    setOutput("zoom", `× ${zoom}`);
    setOutput("divider-place", `column ${slider("divider-place")}`);
    describeDifference(now);
    describePixel(zoom);
    linkToView();
}

function setOutput(id, text) {
    element(id).nextElementSibling.textContent = text;
    element(id).setAttribute("aria-valuetext", text);
}

// The bar under a difference: its colours and the radiance at its ends.
function describeDifference(now) {
    const bar = element("scale-of-difference");
    bar.hidden = now !== "difference";
    const absolute = element("map").value === "absolute";
    const limit = threeDigits(1 / differenceScale());
    bar.firstElementChild.textContent = absolute ? "0" : `−${limit}`;
    bar.lastElementChild.textContent = absolute ? limit : `+${limit}`;
    const ramp = bar.querySelector("canvas");
    const output = new ImageData(ramp.width, 1);
    for (let x = 0; x < ramp.width; ++x) {
        const grey = toSrgb(x / (ramp.width - 1));
        output.data.set([...(absolute ? [grey, grey, grey] : data.differenceColours[x]), 255], 4 * x);
    }
    ramp.getContext("2d").putImageData(output, 0, 0);
}

function describePixel(zoom) {
    const outline = element("pixel");
    outline.hidden = !place;
    const values = element("values");
    values.caption.textContent = place ? `Radiance at pixel ${place[0]}, ${place[1]}` : "Radiance at a pixel";
    const index = place ? 3 * (place[1] * scene.width + place[0]) : NaN;
    const rows = [(channel) => a[index + channel], (channel) => b[index + channel],
                  (channel) => a[index + channel] - b[index + channel]];
    rows.forEach((valueOf, row) => {
        for (let channel = 0; channel < 3; ++channel)
            values.tBodies[0].rows[row].cells[channel + 1].textContent = place ? threeDigits(valueOf(channel)) : "";
    });
    if (!place) return;
    Object.assign(outline.style, {left: `${zoom * place[0]}px`, top: `${zoom * place[1]}px`, width: `${zoom}px`,
                                  height: `${zoom}px`});
}

// Images are decoded when they are first shown. A choice made while another one is decoded wins.
async function load() {
    const wanted = [shotOf("a"), shotOf("b"), layer()];
    try {
        const decoded = await Promise.all(wanted.slice(0, 2).map((shot) => radianceOf(shot, wanted[2], scene)));
        if (wanted[0] !== shotOf("a") || wanted[1] !== shotOf("b") || wanted[2] !== layer()) return;
        [a, b] = decoded;
        draw();
    } catch (error) {
        element("legend").textContent = `This browser cannot unpack the images: ${error.message}`;
    }
}

function fill(slot, fallback) {
    const select = element(`image-${slot}`);
    const before = select.selectedOptions[0]?.textContent;
    const groups = Map.groupBy(scene.images.keys(), (index) => scene.images[index].group);
    select.replaceChildren(...Array.from(groups, ([group, indices]) => {
        const part = document.createElement("optgroup");
        part.label = group;
        part.append(...indices.map((index) => new Option(scene.images[index].name, index)));
        return part;
    }));
    const same = scene.images.findIndex((image) => image.name === before);
    select.value = same >= 0 ? same : fallback;
    fillSeeds(slot);
}

// The seeds of the image that is chosen; the one that was chosen before stays where it is there.
function fillSeeds(slot) {
    const select = element(`seed-${slot}`);
    const before = select.selectedOptions[0]?.textContent;
    const {seeds} = chosen(slot);
    select.replaceChildren(...seeds.map(({seed}, index) => new Option(seed ?? "–", index)));
    select.value = Math.max(0, seeds.findIndex(({seed}) => String(seed) === before));
    select.disabled = seeds.length < 2;
}

// First the last pass of the last method against the reference, or without one against the first method's first.
function showScene() {
    scene = data.scenes[element("scene").value];
    a = b = null;
    place = null;
    canvas.width = scene.width;
    canvas.height = scene.height;
    element("divider-place").max = scene.width;
    element("divider-place").value = Math.round(scene.width / 2);
    element("zoom").value = Math.max(1, Math.floor(512 / Math.max(scene.width, scene.height)));
    const reference = scene.images.findIndex((image) => image.group === "reference");
    fill("a", Math.max(0, (reference < 0 ? scene.images.length : reference) - 1));
    fill("b", Math.max(0, reference));
    load();
}

function setMode(name) {
    document.querySelector(`input[name=mode][value=${name}]`).checked = true;
    draw();
}

function flip() {
    if (mode() === "flip") flipped = !flipped;
    setMode("flip");
}

const inside = (x, y) => [Math.min(Math.max(x, 0), scene.width - 1), Math.min(Math.max(y, 0), scene.height - 1)];

function moveTo(x, y) {
    place = inside(x, y);
    describePixel(slider("zoom"));
    linkToView();
}

// The wheel zooms about the pixel under the mouse, and scrolls the page where there is no step left.
function zoomAt(event) {
    const before = slider("zoom");
    element("zoom").value = before - Math.sign(event.deltaY);
    const ratio = slider("zoom") / before;
    if (!a || !event.deltaY || ratio === 1) return;
    event.preventDefault();
    const stage = element("stage");
    const [x, y] = [event.clientX, event.clientY].map((at, axis) =>
        at - [stage.getBoundingClientRect().left, stage.getBoundingClientRect().top][axis]);
    const [left, top] = [stage.scrollLeft, stage.scrollTop];
    draw();
    stage.scrollTo((left + x) * ratio - x, (top + y) * ratio - y);
}

// A view as the end of an address, by names, so that it outlives a report that is made again with more images.
const choices = ["layer", "map", "gain", "exposure", "zoom", "divider-place"];

function linkToView() {
    const view = new URLSearchParams({scene: scene.name, mode: mode(), flipped: Number(flipped)});
    for (const slot of ["a", "b"]) {
        view.set(slot, chosen(slot).name);
        view.set(`seed-${slot}`, shotOf(slot).seed ?? "");
    }
    for (const id of choices) view.set(id, element(id).value);
    if (place) view.set("pixel", place.join());
    element("link").href = `#view?${view}`;
}

// Shows the view that the address names; what this page does not have of it stays as it is.
function followLink() {
    if (!location.hash.startsWith("#view?")) return;
    const view = new URLSearchParams(location.hash.slice(6));
    const index = data.scenes.findIndex((one) => one.name === view.get("scene"));
    if (index >= 0) element("scene").value = index;
    showScene();
    for (const slot of ["a", "b"]) {
        const image = scene.images.findIndex((one) => one.name === view.get(slot));
        if (image >= 0) element(`image-${slot}`).value = image;
        fillSeeds(slot);
        const seed = chosen(slot).seeds.findIndex((one) => String(one.seed ?? "") === view.get(`seed-${slot}`));
        if (seed >= 0) element(`seed-${slot}`).value = seed;
    }
    for (const id of choices) if (view.has(id)) element(id).value = view.get(id);
    flipped = view.get("flipped") === "1";
    const radio = document.querySelector(`input[name=mode][value="${CSS.escape(view.get("mode") ?? "")}"]`);
    if (radio) radio.checked = true;
    const pixel = (view.get("pixel") ?? "").split(",").map(Number);
    if (pixel.length === 2 && pixel.every(Number.isInteger)) place = inside(...pixel);
    element("images").scrollIntoView();
    load();
}

// The next value of a drop-down, after the last the first.
function next(id) {
    const select = element(id);
    if (!select.disabled) select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
    load();
}

function chooseNumber(number, slot) {
    const select = element(`image-${slot}`);
    if (number > select.options.length) return;
    select.selectedIndex = number - 1;
    if (mode() === "flip") flipped = slot === "b";
    fillSeeds(slot);
    load();
}

const step = (x, y) => () => place ? moveTo(place[0] + x, place[1] + y)
    : moveTo(scene.width >> 1, scene.height >> 1);
const nextSeed = () => { next("seed-a"); next("seed-b"); };
const keysOverPicture = {" ": flip, w: () => setMode("wipe"), d: () => setMode("difference"), l: () => next("layer"), s: nextSeed};
const keysInPicture = {ArrowLeft: step(-1, 0), ArrowRight: step(1, 0), ArrowUp: step(0, -1), ArrowDown: step(0, 1)};

function actionOf(event) {
    if (!a || event.ctrlKey || event.altKey || event.metaKey) return undefined;
    const hasFocus = document.activeElement === picture;
    const digit = /^Digit([1-9])$/.exec(event.code);    // the key, whatever it writes with shift
    if (digit && (hasFocus || picture.matches(":hover")))
        return () => chooseNumber(Number(digit[1]), event.shiftKey ? "b" : "a");
    return (hasFocus || picture.matches(":hover")) && keysOverPicture[event.key] ||
        hasFocus && keysInPicture[event.key] || undefined;
}

function listenToKeys() {
    document.addEventListener("keydown", (event) => {
        const action = actionOf(event);
        if (!action) return;
        event.preventDefault();
        action();
    });
    // In some browsers it is the key's release that presses a button with the focus.
    document.addEventListener("keyup", (event) => {
        if (actionOf(event)) event.preventDefault();
    });
}

function listenToMouse() {
    picture.addEventListener("wheel", zoomAt, {passive: false});
    picture.addEventListener("pointermove", (event) => {
        if (!a) return;
        const box = canvas.getBoundingClientRect();
        const x = (event.clientX - box.left) / slider("zoom");
        moveTo(Math.floor(x), Math.floor((event.clientY - box.top) / slider("zoom")));
        if (mode() !== "wipe") return;
        element("divider-place").value = Math.round(x);
        draw();
    });
}

function listenToControls() {
    element("scene").addEventListener("change", showScene);
    for (const slot of ["a", "b"]) {
        element(`image-${slot}`).addEventListener("change", () => { fillSeeds(slot); load(); });
        element(`seed-${slot}`).addEventListener("change", load);
    }
    element("layer").addEventListener("change", load);
    for (const id of ["divider-place", "map", "gain", "exposure", "zoom"]) element(id).addEventListener("input", draw);
    for (const radio of document.querySelectorAll("input[name=mode]")) radio.addEventListener("change", draw);
    element("flip").addEventListener("click", flip);
}

if (picture) {
    element("scene").append(...data.scenes.map((one, index) => new Option(one.name, index)));
    listenToKeys();
    listenToMouse();
    listenToControls();
    showScene();
    followLink();
    addEventListener("hashchange", followLink);
}
