// Surfaces in single precision, as in lanes: diffuse, mirror and refractive materials. Other materials use double precision.

typedef struct {
    vec_s wi;
    rgb_s weight;
    single density;
    int found, is_delta;
} bsdf_sample_s;

typedef struct {
    rgb_s emission, albedo;
    single eta, inverse, r0;
    surface wide;
} surface_s;

FN rgb_s narrowed(rgb c) { return rgb_of_s((single)c.r, (single)c.g, (single)c.b); }
FN surface_s surface_of_s(const scene *s, u32 object) {
    surface_s of;
    of.wide = surface_of(s, object);
    of.emission = narrowed(of.wide.emission);
    of.albedo = narrowed(of.wide.albedo);
    of.eta = (single)of.wide.eta;
    of.inverse = (single)of.wide.inverse;
    of.r0 = (single)of.wide.r0;
    return of;
}

FN bsdf_sample_s scattered_s(vec_s wi, rgb_s weight, single density, int is_delta) {
    bsdf_sample_s sample;
    sample.found = 1;
    sample.is_delta = is_delta;
    sample.wi = wi;
    sample.weight = weight;
    sample.density = density;
    return sample;
}

#if HAS_DIELECTRIC
typedef struct { vec_s refracted; single reflectance; int is_total; } interface_s;
FN interface_s interface_of_s(const surface_s *of, vec_s wo, int inside) {
    interface_s at;
    single eta = inside ? of->eta : of->inverse, cos2;
    at.refracted = refracted_s(wo, eta, &cos2);
    at.is_total = cos2 < 0.0f;
    at.reflectance = of->wide.exact_fresnel ? fresnel_s(wo.z, inside ? of->inverse : of->eta)
                                            : schlick_s(eta < 1.0f ? wo.z : -at.refracted.z, of->r0);
    return at;
}
#endif

FN bsdf_sample_s sample_bsdf_s(const surface_s *of, vec_s wo, int inside, pair_s p) {
    switch (of->wide.kind) {
    case MATERIAL_DIFFUSE: {
        vec_s wi = cosine_hemisphere_s(p);
        return scattered_s(wi, of->albedo, wi.z * INVERSE_PI_S, 0);
    }
    case MATERIAL_MIRROR:
        return scattered_s(reflected_s(wo), of->albedo, 0.0f, 1);
#if HAS_DIELECTRIC
    case MATERIAL_DIELECTRIC: {
        interface_s at = interface_of_s(of, wo, inside);
        if (at.is_total) return scattered_s(reflected_s(wo), of->albedo, 0.0f, 1);
        single chance = 0.25f + 0.5f * at.reflectance;
        if (p.u < chance) return scattered_s(reflected_s(wo), dimmed_s(of->albedo, at.reflectance / chance), 0.0f, 1);
        return scattered_s(at.refracted, dimmed_s(of->albedo, (1.0f - at.reflectance) / (1.0f - chance)), 0.0f, 1);
    }
#endif
    default: {
        pair wide;
        wide.u = p.u;
        wide.v = p.v;
        bsdf_sample sample = sample_bsdf(&of->wide, widened(wo), inside, wide);
        vec_s wi = vec_of_s((single)sample.wi.x, (single)sample.wi.y, (single)sample.wi.z);
        bsdf_sample_s narrow = scattered_s(wi, narrowed(sample.weight), (single)sample.density, sample.is_delta);
        narrow.found = sample.found;
        return narrow;
    }
    }
}

FN rgb_s scattered_light_s(const surface_s *of, vec_s wo, vec_s wi) {
    switch (of->wide.kind) {
    case MATERIAL_DIFFUSE:
        if (!(0.0f < wo.z * wi.z)) return grey_s(0.0f);
        return dimmed_s(dimmed_s(of->albedo, INVERSE_PI_S), MAGNITUDE_S(wi.z));
    case MATERIAL_MIRROR:
    case MATERIAL_DIELECTRIC:
        return grey_s(0.0f);
    default:
        return narrowed(scattered_light(&of->wide, widened(wo), widened(wi)));
    }
}

FN single bsdf_density_s(const surface_s *of, vec_s wo, vec_s wi) {
    if (of->wide.kind == MATERIAL_DIFFUSE) return MAGNITUDE_S(wi.z) * INVERSE_PI_S;
    return (single)bsdf_density(&of->wide, widened(wo), widened(wi));
}

FN int two_lobes_s(const surface_s *of, vec_s wo, int inside, bsdf_sample_s *first, bsdf_sample_s *second) {
#if HAS_DIELECTRIC
    if (of->wide.kind == MATERIAL_DIELECTRIC) {
        interface_s at = interface_of_s(of, wo, inside);
        if (at.is_total) return 0;
        *first = scattered_s(reflected_s(wo), dimmed_s(of->albedo, at.reflectance), 0.0f, 1);
        *second = scattered_s(at.refracted, dimmed_s(of->albedo, 1.0f - at.reflectance), 0.0f, 1);
        return 1;
    }
#endif
    return 0;
}
