"""GGX facets as glTF's appendix B and raykiln's documentation state them, as a BSDF plug-in of Mitsuba.

Distribution, sampling of visible normals and Fresnel's equations are Mitsuba's own. What is added is what
it lacks: masking correlated with height, G2 = 1/(1 + L_i + L_o) with L = 1/G1 - 1 of Mitsuba's G1, and the
light that meets several facets (Kulla & Conty 2017), from energies that are integrated here with numpy.
With `separable` and `single` nothing is added, and pictures must equal those of Mitsuba's own plug-ins:
a row of the table checks that.
"""

import drjit as dr
import mitsuba as mi
import numpy as np

COSINES = 128


def _g1(c, alpha):
    return 2 * c / (c + np.sqrt(c * c + alpha * alpha * (1 - c * c)))


def _g2(ci, co, alpha, separable):
    gi, go = _g1(ci, alpha), _g1(co, alpha)
    return gi * go if separable else 1 / (1 / gi + 1 / go - 1)


def _visible_facets(cosine, alpha, n):
    """Normals seen from a cosine with equal weights: Heitz's stretched hemisphere, by midpoints."""
    u, v = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
    view = np.array([alpha * np.sqrt(1 - cosine**2), 0, cosine])
    view /= np.linalg.norm(view)
    z = (1 - u**3) * (1 + view[2]) - view[2]  # u^3: steep facets finely
    weight = 3 * u**2 / n**2
    s = np.sqrt(np.maximum(1 - z * z, 0))
    phi = 2 * np.pi * v
    h = np.stack([alpha * (s * np.cos(phi) + view[0]), alpha * (s * np.sin(phi) + view[1]), z + view[2]], -1)
    return h / np.linalg.norm(h, axis=-1, keepdims=True), weight


def reflection_energy(alpha, separable=False, n=96):
    """For each cosine: what facets that reflect all send out at once, and the part of it that goes with
    Schlick's (1 - c)^5."""
    whole, grazing = [], []
    for cosine in (np.arange(COSINES) + 0.5) / COSINES:
        h, weight = _visible_facets(cosine, alpha, n)
        c = h @ np.array([np.sqrt(1 - cosine**2), 0, cosine])
        out = 2 * c * h[..., 2] - cosine
        seen = np.where(out > 0, _g2(np.maximum(out, 1e-9), cosine, alpha, separable) / _g1(cosine, alpha), 0)
        whole.append((seen * weight).sum())
        grazing.append((seen * weight * np.clip(1 - c, 0, 1) ** 5).sum())
    return np.array(whole), np.array(grazing)


def border_energy(alpha, eta, n=80):
    """What one meeting with the border of a body of relative index eta leaves, for each cosine."""
    kept = []
    for cosine in (np.arange(COSINES) + 0.5) / COSINES:
        h, weight = _visible_facets(cosine, alpha, n)
        c = np.clip(h @ np.array([np.sqrt(1 - cosine**2), 0, cosine]), 0, 1)
        sin2 = (1 - c * c) / eta**2
        t = np.sqrt(np.maximum(1 - sin2, 0))
        f = np.where(sin2 >= 1, 1.0, 0.5 * (((c - eta * t) / (c + eta * t)) ** 2 +
                                            ((eta * c - t) / (eta * c + t)) ** 2))
        up = 2 * c * h[..., 2] - cosine
        down = -(h[..., 2] * (c / eta - t) - cosine / eta)
        total = np.zeros_like(c)
        for share, out in ((f, up), (1 - f, down)):
            seen = _g2(np.maximum(out, 1e-9), cosine, alpha, False) / _g1(cosine, alpha)
            total += np.where(out > 0, share * seen, 0)
        kept.append((total * weight).sum())
    return np.array(kept)


def _mean(values):
    cosines = (np.arange(COSINES) + 0.5) / COSINES
    return (values * cosines).sum(-1) * 2 / COSINES


class Table:
    """Linear between the middles of cells of the cosine."""

    def __init__(self, values):
        self.values = mi.Float(np.asarray(values, np.float32))

    def __call__(self, cosine):
        place = dr.clip(cosine * COSINES - 0.5, 0, COSINES - 1.001)
        low = mi.UInt32(place)
        share = place - mi.Float(low)
        return dr.lerp(dr.gather(mi.Float, self.values, low), dr.gather(mi.Float, self.values, low + 1), share)


class Facets(mi.BSDF):
    """Shared by both kinds: distribution, masking, mixed sampling."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.alpha = props.get("alpha", 0.1)
        self.separable, self.single = props.get("separable", False), props.get("single", False)
        self.ggx = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True)

    def masking(self, wi, wo, h):
        a, b = self.ggx.smith_g1(wi, h), self.ggx.smith_g1(wo, h)
        if self.separable:
            return a * b
        both = dr.rcp(dr.maximum(a, 1e-20)) + dr.rcp(dr.maximum(b, 1e-20)) - 1
        return dr.select((a > 0) & (b > 0), dr.rcp(both), 0)

    def eval_pdf(self, ctx, si, wo, active):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def drawn(self, sample, wo, value, pdf, kind, eta, active):
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo, bs.pdf, bs.eta = wo, pdf, eta
        bs.sampled_component, bs.sampled_type = 0, mi.UInt32(+kind)
        ok = active & (pdf > 0)
        return bs, dr.select(ok, value / dr.maximum(pdf, 1e-30), mi.Color3f(0))


class OpaqueFacets(Facets):
    def __init__(self, props):
        Facets.__init__(self, props)
        base, metallic = mi.ScalarColor3f(props["base"]), props["metallic"]
        self.normal = mi.Color3f(base * metallic + mi.ScalarColor3f(0.04) * (1 - metallic))
        self.base = mi.Color3f(base * (1 - metallic))
        self.half = 0.5 if metallic < 1 else 0.0  # share of samples for the diffuse base
        whole, grazing = reflection_energy(self.alpha, self.separable)
        lost_mean, normal = max(1 - _mean(whole), 1e-12), np.array(self.normal).reshape(3)
        f_mean = normal + (1 - normal) / 21
        again = 0 if self.single else f_mean**2 * (1 - lost_mean) / (1 - f_mean * lost_mean)
        albedo = normal[:, None] * (whole - grazing) + grazing + np.reshape(again * np.ones(3), (3, 1)) * (1 - whole)
        self.again, self.lost = mi.Color3f(*(again * np.ones(3)).tolist()), Table(1 - whole)
        self.lost_mean = float(lost_mean)
        self.left = [Table(1 - a) for a in albedo]
        self.left_mean = mi.Color3f(*np.maximum(1 - _mean(albedo), 1e-9).tolist())
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0]

    def eval(self, ctx, si, wo, active):
        i, o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
        h = dr.normalize(si.wi + wo)
        f = self.normal + (1 - self.normal) * dr.power(dr.clip(1 - dr.dot(wo, h), 0, 1), 5)
        value = f * (self.ggx.eval(h) * self.masking(si.wi, wo, h) / dr.maximum(4 * i, 1e-20))
        value += self.again * (self.lost(i) * self.lost(o) * o / (dr.pi * self.lost_mean))
        left = mi.Color3f(*[t(i) * t(o) for t in self.left]) / self.left_mean
        value += self.base * left * (o / dr.pi)
        return dr.select(active & (i > 0) & (o > 0), value, 0)

    def pdf(self, ctx, si, wo, active):
        h = dr.normalize(si.wi + wo)
        mirrored = self.ggx.pdf(si.wi, h) / dr.maximum(4 * dr.dot(wo, h), 1e-20)
        # Some cosine samples even for metals: the light of several facets goes everywhere.
        spread = dr.maximum(self.half, 0.1)
        both = spread * mi.warp.square_to_cosine_hemisphere_pdf(wo) + (1 - spread) * mirrored
        up = (mi.Frame3f.cos_theta(si.wi) > 0) & (mi.Frame3f.cos_theta(wo) > 0)
        return dr.select(active & up, both, 0)

    def sample(self, ctx, si, sample1, sample2, active):
        spread = dr.maximum(self.half, 0.1)
        h, _ = self.ggx.sample(si.wi, sample2)
        wo = dr.select(sample1 < spread, mi.warp.square_to_cosine_hemisphere(sample2),
                       mi.reflect(si.wi, h))
        value, pdf = self.eval_pdf(ctx, si, wo, active)
        return self.drawn(sample1, wo, value, pdf, self.m_flags, 1.0, active)


class GlassFacets(Facets):
    """The border of a body; its light after one meeting is divided by what is left of it."""

    def __init__(self, props):
        Facets.__init__(self, props)
        self.index = props["index"]
        tables = [border_energy(self.alpha, eta) for eta in (self.index, 1 / self.index)]
        self.kept = [Table(np.ones(COSINES) if self.single else t) for t in tables]
        flags = mi.BSDFFlags
        self.m_components = [flags.GlossyReflection | flags.FrontSide | flags.BackSide,
                             flags.GlossyTransmission | flags.FrontSide | flags.BackSide | flags.NonSymmetric]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def _meeting(self, si, wo):
        i, o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
        mirrors = i * o > 0
        eta = dr.select(i > 0, mi.Float(self.index), 1 / self.index)
        h = dr.normalize(si.wi + wo * dr.select(mirrors, 1, eta))
        h = dr.mulsign(h, mi.Frame3f.cos_theta(h))
        f, _, _, _ = mi.fresnel(dr.dot(si.wi, h), self.index)
        ok = (dr.dot(si.wi, h) * i > 0) & (dr.dot(wo, h) * o > 0)
        reach = dr.square(dr.dot(si.wi, h) + eta * dr.dot(wo, h))
        bent = dr.square(eta) * dr.abs(dr.dot(wo, h)) / dr.maximum(reach, 1e-20)
        turn = dr.select(mirrors, dr.rcp(dr.maximum(4 * dr.abs(dr.dot(wo, h)), 1e-20)), bent)
        return i, eta, mirrors, h, dr.select(mirrors, f, 1 - f), turn, ok

    def eval(self, ctx, si, wo, active):
        i, eta, mirrors, h, share, turn, ok = self._meeting(si, wo)
        kept = dr.select(i > 0, self.kept[0](dr.abs(i)), self.kept[1](dr.abs(i)))
        value = self.ggx.eval(h) * self.masking(si.wi, wo, h) * dr.abs(dr.dot(si.wi, h) / i) * turn * share / kept
        value *= dr.select(mirrors, 1, dr.rcp(dr.square(eta)))  # radiance grows with the square of the index
        return dr.select(active & ok, mi.Color3f(value), 0)

    def pdf(self, ctx, si, wo, active):
        i, _, _, h, share, turn, ok = self._meeting(si, wo)
        up = dr.mulsign(mi.Vector3f(si.wi), i)
        return dr.select(active & ok, self.ggx.pdf(up, h) * turn * share, 0)

    def sample(self, ctx, si, sample1, sample2, active):
        i = mi.Frame3f.cos_theta(si.wi)
        h, _ = self.ggx.sample(dr.mulsign(mi.Vector3f(si.wi), i), sample2)
        f, cos_t, eta_it, eta_ti = mi.fresnel(dr.dot(si.wi, h), self.index)
        mirrors = sample1 < f
        wo = dr.select(mirrors, mi.reflect(si.wi, h), mi.refract(si.wi, h, cos_t, eta_ti))
        # Light that leaves to the wrong side of the surface is lost, and not what `eval` has there.
        active &= mirrors == (i * mi.Frame3f.cos_theta(wo) > 0)
        value, pdf = self.eval_pdf(ctx, si, wo, active)
        kind = dr.select(mirrors, mi.UInt32(+mi.BSDFFlags.GlossyReflection), mi.UInt32(+mi.BSDFFlags.GlossyTransmission))
        bs, weight = self.drawn(sample1, wo, value, pdf, self.m_flags, dr.select(mirrors, 1.0, eta_it), active)
        bs.sampled_type = kind
        return bs, weight


_registered = []


def register():
    """Once, with the variant set whose BSDF these classes derive from."""
    if not _registered:
        mi.register_bsdf("gltf_opaque", OpaqueFacets)
        mi.register_bsdf("gltf_glass", GlassFacets)
        _registered.append(True)


class Look:
    """What the glTF converter asks for."""

    def __init__(self, separable=False, single=False):
        self.options = {"separable": separable, "single": single}

    def opaque(self, base, metallic, alpha) -> dict:
        return {"type": "twosided", "bsdf": {
            "type": "gltf_opaque", "base": mi.ScalarColor3f(*base), "metallic": float(metallic),
            "alpha": float(alpha), **self.options}}

    def glass(self, alpha, index) -> dict:
        return {"type": "gltf_glass", "alpha": float(alpha), "index": float(index), **self.options}
