"""Facets as Mitsuba has them, with what is known to differ from glTF as raykiln reads it.

Mitsuba's GGX has separable masking where glTF's is correlated with height, and loses light that meets
several facets, which raykiln keeps.
"""

from mitsuba_parts import Unsupported, rgb


def opaque(base, metallic, alpha) -> dict:
    """`principled` has GGX facets of alpha = roughness^2 and, for metals, Schlick's Fresnel from the
    base colour to 1."""
    if metallic != 1:
        raise Unsupported("layers")
    return {"type": "twosided", "bsdf": {"type": "principled", "base_color": rgb(base), "metallic": 1.0,
                                         "roughness": alpha**0.5, "specular": 0.5}}


def glass(alpha, index) -> dict:
    return {"type": "roughdielectric", "distribution": "ggx", "alpha": alpha, "int_ior": index,
            "ext_ior": 1.0}
