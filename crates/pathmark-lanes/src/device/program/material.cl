// Materials: how surfaces scatter light, `material/`. An object has OBJECT_NUMBERS numbers and one word, its kind and flags.

typedef struct {
    vec wi;
    rgb weight;
    real density;
    int found, is_delta;
} bsdf_sample;

typedef struct {
    u32 kind;
    int exact_fresnel, visible_normals;
    rgb emission, colour, albedo;
    real eta, inverse, r0, alpha, reflectivity;
} surface;

FN surface surface_of(const scene *s, u32 object) {
    GLOBAL const stored *p = s->numbers + s->words[AT_OBJECTS] + OBJECT_NUMBERS * object;
    u32 word = s->words[s->words[AT_KINDS] + object];
    surface of;
    of.kind = word & 0xFFU;
    of.exact_fresnel = (word >> 8) & 1U;
    of.visible_normals = (word >> 9) & 1U;
    of.emission = rgb_at(p);
    of.colour = rgb_at(p + 3);
    of.albedo = rgb_at(p + 6);
    of.eta = p[9];
    of.inverse = p[10];
    of.r0 = p[11];
    of.alpha = p[12];
    of.reflectivity = p[13];
    return of;
}

FN bsdf_sample absorbed(void) {
    bsdf_sample sample;
    sample.found = 0;
    sample.is_delta = 0;
    sample.density = 0.0;
    sample.weight = grey(0.0);
    sample.wi = vec_of(0.0, 0.0, 1.0);
    return sample;
}
FN bsdf_sample delta(vec wi, rgb weight) {
    bsdf_sample sample = absorbed();
    sample.found = sample.is_delta = 1;
    sample.wi = wi;
    sample.weight = weight;
    return sample;
}
FN bsdf_sample scattered(vec wi, rgb weight, real density) {
    bsdf_sample sample = absorbed();
    sample.found = 1;
    sample.wi = wi;
    sample.weight = weight;
    sample.density = density;
    return sample;
}

#if HAS_DIELECTRIC
typedef struct { vec refracted; real reflectance; int is_total; } interface;
FN interface interface_of(const surface *of, vec wo, int inside) {
    interface at;
    real eta = inside ? of->eta : of->inverse, cos2;
    at.refracted = refracted(wo, eta, &cos2);
    at.is_total = cos2 < 0.0;
    at.reflectance = 1.0;
    if (at.is_total) return at;
    if (of->exact_fresnel) {
        at.reflectance = fresnel(wo.z, inside ? of->inverse : of->eta);
    } else {
        at.reflectance = schlick(eta < 1.0 ? wo.z : -at.refracted.z, of->r0);
    }
    return at;
}
#endif

#if HAS_CONDUCTOR || HAS_KD_KS
FN real ggx_r(real alpha, vec w) { return SQUARE_ROOT(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y)); }
FN real ggx_density(real alpha, vec h) {
    if (h.z <= 0.0) return 0.0;
    real alpha2 = alpha * alpha;
    real a = (h.x * h.x + h.y * h.y) / alpha2 + h.z * h.z;
    return 1.0 / (PI * alpha2 * a * a);
}
FN real ggx_unshadowed(real alpha, vec wo, vec wi) {
    real ro = ggx_r(alpha, wo), ri = ggx_r(alpha, wi);
    return wi.z * (wo.z + ro) / (wi.z * ro + wo.z * ri);
}
FN real ggx_reflection(real alpha, vec wo, vec wi) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return 0.0;
    return ggx_density(alpha, unit_vector(plus(wo, wi))) / (2.0 * (wi.z * ggx_r(alpha, wo) + wo.z * ggx_r(alpha, wi)));
}
FN real ggx_pdf(real alpha, vec wo, vec wi) {
    vec sum = plus(wo, wi);
    if (wo.z < 0.0 || sum.z <= 0.0) return 0.0;
    return ggx_density(alpha, unit_vector(sum)) / (2.0 * (wo.z + ggx_r(alpha, wo)));
}
FN vec ggx_visible_normal(real alpha, vec wo, pair p) {
    vec stretched = unit_vector(vec_of(alpha * wo.x, alpha * wo.y, wo.z));
    real height = (1.0 - p.v) * (1.0 + stretched.z);
    real z = height - stretched.z;
    real rim = SQUARE_ROOT(larger(1.0 - z * z, 0.0));
    real sine, cosine;
    turn(p.u, &sine, &cosine);
    return unit_vector(vec_of(alpha * (rim * cosine + stretched.x), alpha * (rim * sine + stretched.y), height));
}
FN vec ggx_mirrored(vec wo, vec h) { return unit_vector(minus(times(h, 2.0 * inner(wo, h)), wo)); }
#endif

#if HAS_CONDUCTOR
FN rgb metal(const surface *of, real cosine) {
    rgb f0 = of->colour;
    return rgb_of(schlick(cosine, f0.r), schlick(cosine, f0.g), schlick(cosine, f0.b));
}
#endif

#if HAS_KD_KS
FN real facet_chance(const surface *of, real reflectance) {
    real matte = (1.0 - reflectance) * max_channel(of->colour);
    return reflectance > 0.0 ? reflectance / (reflectance + matte) : 0.0;
}
FN rgb body_and_facets(const surface *of, real reflectance, vec wo, vec wi) {
    real facets = reflectance * ggx_reflection(of->alpha, wo, wi);
    return mixed(dimmed(of->colour, (1.0 - reflectance) * INVERSE_PI), dimmed(grey(1.0), facets));
}
FN real body_and_facets_pdf(const surface *of, real reflectance, vec wo, vec wi) {
    real cosine = wi.z * INVERSE_PI;
    if (!of->visible_normals) return cosine;
    real chance = facet_chance(of, reflectance);
    return chance * ggx_pdf(of->alpha, wo, wi) + (1.0 - chance) * cosine;
}
FN int chooses(pair *p, real chance) {
    int first = p->u < chance;
    p->u = first ? p->u / chance : (p->u - chance) / (1.0 - chance);
    return first;
}
#endif

FN bsdf_sample sample_bsdf(const surface *of, vec wo, int inside, pair p) {
    switch (of->kind) {
#if HAS_DIFFUSE
    case MATERIAL_DIFFUSE: {
        vec wi = cosine_hemisphere(p);
        return scattered(wi, of->colour, wi.z * INVERSE_PI);
    }
#endif
#if HAS_MIRROR
    case MATERIAL_MIRROR:
        return delta(reflected(wo), of->colour);
#endif
#if HAS_DIELECTRIC
    case MATERIAL_DIELECTRIC: {
        interface at = interface_of(of, wo, inside);
        if (at.is_total) return delta(reflected(wo), dimmed(of->colour, 1.0));
        real chance = 0.25 + 0.5 * at.reflectance;
        if (p.u < chance) return delta(reflected(wo), dimmed(of->colour, at.reflectance / chance));
        return delta(at.refracted, dimmed(of->colour, (1.0 - at.reflectance) / (1.0 - chance)));
    }
#endif
#if HAS_POLISHED
    case MATERIAL_POLISHED: {
        if (p.u < of->reflectivity) return delta(reflected(wo), dimmed(grey(1.0), 1.0));
        real base = 1.0 - of->reflectivity;
        p.u = (p.u - of->reflectivity) / base;
        vec wi = cosine_hemisphere(p);
        return scattered(wi, of->colour, base * wi.z * INVERSE_PI);
    }
#endif
#if HAS_FRESNEL_MIRROR
    case MATERIAL_FRESNEL_MIRROR:
        return delta(reflected(wo), dimmed(grey(1.0), fresnel(wo.z, of->eta)));
#endif
#if HAS_CONDUCTOR
    case MATERIAL_CONDUCTOR: {
        if (of->alpha == 0.0) return delta(reflected(wo), metal(of, wo.z));
        vec h = ggx_visible_normal(of->alpha, wo, p);
        vec wi = ggx_mirrored(wo, h);
        rgb weight = dimmed(metal(of, inner(wo, h)), ggx_unshadowed(of->alpha, wo, wi));
        return wi.z > 0.0 ? scattered(wi, weight, ggx_pdf(of->alpha, wo, wi)) : absorbed();
    }
#endif
#if HAS_KD_KS
    case MATERIAL_KD_KS: {
        real reflectance = fresnel(wo.z, of->eta);
        vec wi;
        if (of->alpha == 0.0) {
            if (chooses(&p, reflectance)) return delta(reflected(wo), grey(1.0));
            wi = cosine_hemisphere(p);
            return scattered(wi, of->colour, (1.0 - reflectance) * wi.z * INVERSE_PI);
        }
        if (of->visible_normals && chooses(&p, facet_chance(of, reflectance)))
            wi = ggx_mirrored(wo, ggx_visible_normal(of->alpha, wo, p));
        else
            wi = cosine_hemisphere(p);
        if (wi.z <= 0.0) return absorbed();
        real pdf = body_and_facets_pdf(of, reflectance, wo, wi);
        return scattered(wi, dimmed(body_and_facets(of, reflectance, wo, wi), wi.z / pdf), pdf);
    }
#endif
    default:
        return absorbed();
    }
}

// The BSDF's value per steradian for two directions; black for delta lobes.
FN rgb bsdf_value(const surface *of, vec wo, vec wi) {
    switch (of->kind) {
#if HAS_DIFFUSE
    case MATERIAL_DIFFUSE:
        return wo.z * wi.z > 0.0 ? dimmed(of->colour, INVERSE_PI) : grey(0.0);
#endif
#if HAS_POLISHED
    case MATERIAL_POLISHED:
        return wo.z * wi.z > 0.0 ? dimmed(of->colour, (1.0 - of->reflectivity) * INVERSE_PI) : grey(0.0);
#endif
#if HAS_CONDUCTOR
    case MATERIAL_CONDUCTOR: {
        if (of->alpha == 0.0) return grey(0.0);
        vec sum = plus(wo, wi);
        return dimmed(metal(of, 0.5 * SQUARE_ROOT(inner(sum, sum))), ggx_reflection(of->alpha, wo, wi));
    }
#endif
#if HAS_KD_KS
    case MATERIAL_KD_KS: {
        if (wo.z <= 0.0 || wi.z <= 0.0) return grey(0.0);
        real reflectance = fresnel(wo.z, of->eta);
        if (of->alpha == 0.0) return dimmed(of->colour, (1.0 - reflectance) * INVERSE_PI);
        return body_and_facets(of, reflectance, wo, wi);
    }
#endif
    default:
        return grey(0.0);
    }
}

// The density per steradian with which `sample_bsdf` chooses `wi`.
FN real bsdf_density(const surface *of, vec wo, vec wi) {
    switch (of->kind) {
#if HAS_DIFFUSE
    case MATERIAL_DIFFUSE:
        return wo.z * wi.z > 0.0 ? MAGNITUDE(wi.z) * INVERSE_PI : 0.0;
#endif
#if HAS_POLISHED
    case MATERIAL_POLISHED:
        return wo.z * wi.z > 0.0 ? (1.0 - of->reflectivity) * MAGNITUDE(wi.z) * INVERSE_PI : 0.0;
#endif
#if HAS_CONDUCTOR
    case MATERIAL_CONDUCTOR:
        return of->alpha != 0.0 && wi.z > 0.0 ? ggx_pdf(of->alpha, wo, wi) : 0.0;
#endif
#if HAS_KD_KS
    case MATERIAL_KD_KS: {
        if (wo.z < 0.0 || wi.z <= 0.0) return 0.0;
        real reflectance = fresnel(wo.z, of->eta);
        if (of->alpha == 0.0) return (1.0 - reflectance) * wi.z * INVERSE_PI;
        return body_and_facets_pdf(of, reflectance, wo, wi);
    }
#endif
    default:
        return 0.0;
    }
}

// Both delta lobes of a surface that reflects and transmits, each weighted by its share. Returns 0 if the surface does not have two.
FN int two_lobes(const surface *of, vec wo, int inside, bsdf_sample *first, bsdf_sample *second) {
#if HAS_DIELECTRIC
    if (of->kind == MATERIAL_DIELECTRIC) {
        interface at = interface_of(of, wo, inside);
        if (at.is_total) return 0;
        *first = delta(reflected(wo), dimmed(of->colour, at.reflectance));
        *second = delta(at.refracted, dimmed(of->colour, 1.0 - at.reflectance));
        return 1;
    }
#endif
    return 0;
}

// The share of light from `wi` that is scattered to `wo`: the BSDF's value times the cosine.
FN rgb scattered_light(const surface *of, vec wo, vec wi) { return dimmed(bsdf_value(of, wo, wi), MAGNITUDE(wi.z)); }
