"""MaterialX: documents that its own package finds valid, and the OSL that it generates of every node, by Cycles.

Nothing is set in the package: constants are written with the six decimals that it takes by default.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

import MaterialX
import numpy as np
from MaterialX import PyMaterialXGenGlsl, PyMaterialXGenOsl, PyMaterialXGenShader
from points import CONFIGURATIONS, DIRECTORY, functions
from test_osl import emission, render, squares  # noqa: F401 (squares is a fixture)

PROGRAM = Path(os.environ.get("TRANSLUCID", Path(__file__).resolve().parents[4] / "target/debug/translucid")).resolve()


def read(path):
    """A document with the library of MaterialX behind it."""
    document, library = MaterialX.createDocument(), MaterialX.createDocument()
    MaterialX.loadLibraries(MaterialX.getDefaultDataLibraryFolders(), MaterialX.getDefaultDataSearchPath(), library)
    document.setDataLibrary(library)
    MaterialX.readFromXmlFile(document, str(path))
    is_valid, message = document.validate()
    assert is_valid, message
    return document


def osl(document, function):
    """The shader that MaterialX generates of a node."""
    kind = "float" if len(function.outputs) == 1 else "multioutput"
    node = document.addNode(f"translucid_{function.name}", f"it_{function.name}", kind)
    node.addInputsFromNodeDef()
    is_valid, message = document.validate()
    assert is_valid, message
    return generated(PyMaterialXGenOsl.OslShaderGenerator.create(), node)


def generated(generator, node):
    """The shader of a generator for a node."""
    context = PyMaterialXGenShader.GenContext(generator)
    context.registerSourceCodeSearchPath(MaterialX.getDefaultDataSearchPath())
    return generator.generate("it", node, context).getSourceCode(PyMaterialXGenShader.PIXEL_STAGE)


def test_nodes_agree_with_double_precision(squares, tmp_path):  # noqa: F811
    # Those of the other configuration differ in constants
    configuration = CONFIGURATIONS[0]
    document = read(DIRECTORY / configuration / "export.materialx")
    # What the generated shaders include
    for folder in MaterialX.getDefaultDataSearchPath().asString().split(os.pathsep):
        shutil.copytree(Path(folder) / "libraries/stdlib/genosl/include", tmp_path, dirs_exist_ok=True)
    faults = []
    for function in functions(configuration):
        source = osl(document, function)
        # MaterialX renames what the language has names for
        inputs, outputs = (
            re.findall(rf"^    {kind} (\w+) = [-0-9.]+,?$", source[source.index("shader it") :], re.MULTILINE)
            for kind in ("float", "output float")
        )
        assert len(inputs) == len(function.arguments) and len(outputs) == len(function.outputs)
        socket = lambda tree, script, i: emission(tree, script, outputs[i])
        results = render(squares, source, function, tmp_path, inputs, socket)
        faults += function.fault(results, "MaterialX", "osl")
    assert not faults


def test_material_is_valid_and_generates(tmp_path):
    path = tmp_path / "material.mtlx"
    words = ["--surface-albedo", "0.8,0.5,0.3", "--mfp", "0.5,2,1"]
    subprocess.run([PROGRAM, "export", "--to", "materialx", "--what", "material", *words, "-o", path], check=True)
    document = read(path)
    surface = document.getNode("translucid_surface")
    value = lambda name: surface.getInput(name).getValue()
    assert surface.getCategory() == "open_pbr_surface" and value("subsurface_weight") == 1.0
    assert np.allclose([*value("subsurface_color")], [0.8, 0.5, 0.3], rtol=1e-6)
    lengths = value("subsurface_radius") * np.array([*value("subsurface_radius_scale")])
    assert np.allclose(lengths, [0.5, 2.0, 1.0], rtol=1e-6)
    # Scales of OpenPBR are at most 1
    assert max(value("subsurface_radius_scale")) == 1.0
    for generator in [PyMaterialXGenOsl.OslShaderGenerator.create(), PyMaterialXGenGlsl.GlslShaderGenerator.create()]:
        assert "subsurface_radius_scale" in generated(generator, document.getNode("translucid_material"))
