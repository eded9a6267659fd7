"""Bakes the ambient occlusion of the object "ground" with Blender's Cycles, on the CPU.

    blender -b --factory-startup --python cycles_bake.py -- SCENE.obj SIDE SAMPLES OUT.raw

OUT.raw gets SIDE x SIDE floats, the bottom row first. Prints the seconds that the bake took.
"""
import array
import sys
import time

import bpy


def main():
    scene_path, side, samples, out_path = sys.argv[sys.argv.index("--") + 1:]
    side = int(side)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.obj_import(filepath=scene_path)
    ground = bpy.data.objects["ground"]

    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = int(samples)
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.render.bake.margin = 0
    scene.world = bpy.data.worlds.new("sky")
    scene.world.light_settings.distance = 1000  # m: all that there is

    image = bpy.data.images.new("occlusion", side, side, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    material = bpy.data.materials.new("baked")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    ground.data.materials.clear()
    ground.data.materials.append(material)
    bpy.ops.object.select_all(action="DESELECT")
    ground.select_set(True)
    bpy.context.view_layer.objects.active = ground

    begin = time.perf_counter()
    bpy.ops.object.bake(type="AO")
    seconds = time.perf_counter() - begin

    pixels = array.array("f", bytes(16 * side * side))
    image.pixels.foreach_get(pixels)
    with open(out_path, "wb") as out:
        pixels[0::4].tofile(out)
    print(f"cycles_seconds {seconds:.3f}")


main()
