"""Light and material of the parts: what VTK does with two lights that turn with the camera, in fewer steps.

Nearly all of the time of a picture is spent on the colour of pixels. VTK raises the highlight to a power by
logarithms, and asks after the colour whether the pixel is there at all, so that the test of depth comes last.
"""

from __future__ import annotations

from typing import Any, Final

_KEY: Final = ((-0.7, 1.1, 1.3), 0.88, (255, 250, 242))
_FILL: Final = ((1.2, -0.1, 0.9), 0.38, (226, 235, 255))
# Highlights are those of a pale sky.
_SKY: Final = (173, 216, 230)
_AMBIENT, _DIFFUSE, _SPECULAR, _POWER = 0.42, 0.66, 0.22, 30.0
# Light alone would make a pale shape dark on one side.
_FADED: Final = (0.78, 0.24, 0.0)

_TAG: Final = "//VTK::Light::Impl"
_PRESENT: Final = "if (gl_FragData[0].a <= 0.0)\n    {\n    discard;\n    }"
_BEGIN: Final = """
  float facing = dot(normalVCVSOutput, toEye);
  vec3 diffuse = vec3(0.0), specular = vec3(0.0);
  float d, m, m2, m4, m8;
"""
# With n the normal, l the direction of the light, e that to the eye: the mirrored light meets the eye at
# reflect(l, n) . e = l . e - 2 (n . l) (n . e), and the highlight is its 30th power.
_LIGHT: Final = """
  d = -dot(normalVCVSOutput, lightDirectionVC{k});
  m = max(0.0, dot(lightDirectionVC{k}, toEye) + 2.0 * d * facing);
  m2 = m * m; m4 = m2 * m2; m8 = m4 * m4;
  diffuse += max(d, 0.0) * lightColor{k};
  specular += (d > 0.0 ? m8 * m8 * m8 * m4 * m2 : 0.0) * lightColor{k};
"""
_END: Final = """
  gl_FragData[0] = vec4(ambientColor + diffuse * diffuseColor + specular * specularColor, opacity);
"""


def add_lights(renderer: Any) -> None:
    """Key and fill light that turn with the camera, so that every view is lit alike."""
    from vtkmodules.vtkRenderingCore import vtkLight

    for position, intensity, color in (_KEY, _FILL):
        light: Any = vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*position)
        light.SetIntensity(intensity)
        light.SetColor(*(channel / 255 for channel in color))
        renderer.AddLight(light)


def shade(actor: Any, *, smooth: bool, parallel: bool) -> None:
    """Give a part its material.

    Args:
        actor: Of the part.
        smooth: Whether normals are averaged over the facets.
        parallel: Whether all lines of sight are parallel.
    """
    material = actor.GetProperty()
    _reflect(material, _AMBIENT, _DIFFUSE, _SPECULAR)
    material.SetSpecularColor(*(channel / 255 for channel in _SKY))
    material.SetSpecularPower(_POWER)
    # Surfaces are closed: hiding what is turned away halves the work, and thin shells do not flicker.
    material.BackfaceCullingOn()
    if smooth:
        material.SetInterpolationToPhong()
    else:
        material.SetInterpolationToFlat()
    eye = "vec3(0.0, 0.0, 1.0)" if parallel else "normalize(-vertexVC.xyz)"
    text = f"vec3 toEye = {eye};" + _BEGIN + "".join(_LIGHT.format(k=k) for k in (0, 1)) + _END
    program = actor.GetShaderProperty()
    program.AddFragmentShaderReplacement(_TAG, True, text, False)
    program.AddFragmentShaderReplacement(_PRESENT, False, "", False)


def fade(actor: Any) -> None:
    """Give a part the material of an earlier shape."""
    _reflect(actor.GetProperty(), *_FADED)


def _reflect(material: Any, ambient: float, diffuse: float, specular: float) -> None:
    """Set the shares of light that come back."""
    material.SetAmbient(ambient)
    material.SetDiffuse(diffuse)
    material.SetSpecular(specular)
