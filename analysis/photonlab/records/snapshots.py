"""Pictures of all seeds of a method at a pass, with what they are judged by."""

from photonlab.records import images, references


def last_common_pass(scene):
    """The last pass of which every method that has snapshots has one of each of its seeds that have any; None without."""
    passes = [set(shown) for label in scene.labels for shown in by_seed(scene, label).values()]
    common = set.intersection(*passes) if passes else set()
    return max(common - {0}, default=None)


def by_seed(scene, label):
    """{seed: {pass: file}} of a method's runs that have snapshots."""
    runs = scene.of_method(label).drop_duplicates("run")
    found = {int(seed): scene.run(run).snapshots for seed, run in zip(runs["seed"], runs["run"]) if scene.has_run(run)}
    return {seed: shown for seed, shown in found.items() if shown}


def halves_of(scene, label, component):
    """[A, B] of what a method was judged by, a single image twice; None without a reference that has the component."""
    row = scene.of_method(label).iloc[0]
    if not scene.has_run(row["run"]):
        return None
    judge = references.reference_of(scene, scene.run(row["run"]).description)
    if judge is None or not judge.halves:
        return None
    halves = [images.read_component(file, component, row["direct"] == "photons") for file in judge.halves]
    return None if any(half is None for half in halves) else [halves[0], halves[-1]]


def images_of(scene, label, component, number):
    """[image] of a method's seeds after pass `number`."""
    found = [images.read_component(shown[number], component) for shown in by_seed(scene, label).values() if number in shown]
    return [image for image in found if image is not None]


def judged_images(scene, component, passes):
    """(label, [image], [A, B]) of each method that has both, at its pass, {label: pass}."""
    for label, number in passes.items():
        halves = halves_of(scene, label, component)
        shown = images_of(scene, label, component, number) if halves else []
        if shown:
            for image in shown:
                images.require_same_size(f"{scene.folder}: {label}", image, "its reference", halves[0])
            yield label, shown, halves
