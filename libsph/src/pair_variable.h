/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loops of pair_loops.h where every particle has a smoothing length of its own (S.26), after pair_kernel.h.
 * Those of one length for all stay as they are: a pair here takes two more loads and a kernel more. */

/* 1/h^(d+2) */
PART_LANES vec slope_power(const sph_lanes *in, vec per_h) {
  const vec p2 = per_h * per_h;
  return in->dimensions == 2 ? p2 * p2 : p2 * p2 * per_h;
}

/* S.26: a's own sums with its own length; S.5 and S.11 with the mean of both. */
PART_LANES void variable_density_loop(const sph_lanes *in, int from, int to, double *sum,
                                      sph_kernel_function shape, sph_kernel_function slope) {
  const vec norm = vec_all(in->unit_norm);
  for (int i = from; i < to; i++) {
    row r = take_row(in, i);
    const vec per_h = vec_all(in->lens[2 * (size_t)i]);
    const vec own = norm * slope_power(in, per_h), own_norm = own / (per_h * per_h);
    vec s[8];
    for (int c = 0; c < 8; c++)
      s[c] = vec_all(0.0);
    for (; r.k < r.end; r.k += PART_WIDTH) {
      vec b[8], d[3], u[3];
      vec_load_8(in->xv, in->partner + r.k, b);
      const vec d2 = separate(&r, b, d, u), distance = vec_sqrt(d2), q = distance * per_h;
      const vec f = b[3] * own * slope(q), w = b[3] * own_norm * shape(q);
      s[0] += f * (d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
      s[6] -= f * d2;
      s[7] += vec_keep(vec_less(vec_all(0.0), d2), w);
      if (in->seen)
        s[5] += w * looser(in, r.eps, in->partner + r.k);
      if (!in->diffuse && !in->smooth)
        continue;
      const vec per_hb = vec_load_1(in->lens, 2, in->partner + r.k), qb = distance * per_hb;
      const vec power = norm * slope_power(in, per_hb);
      if (in->diffuse) {
        vec flow = b[7] - r.p + balanced(in, i, in->partner + r.k, d);
        if (in->porous)
          flow *= 0.5 * (r.eps + vec_load_1(in->mass + 2, 4, in->partner + r.k));
        s[1] += 0.25 * (1.0 / per_h + 1.0 / per_hb) * (f + b[3] * power * slope(qb)) * flow;
      }
      if (in->smooth) {
        const vec both = 0.5 * (w + b[3] * power / (per_hb * per_hb) * shape(qb));
        for (int c = 0; c < 3; c++)
          s[2 + c] -= both * u[c];
      }
    }
    for (int c = 0; c < 8; c++)
      sum[SPH_SUMS * (size_t)i + (size_t)c] = vec_sum(s[c]);
  }
}

/* The number of particles about each in a unit of volume, and what its derivative by h needs. */
PART_LANES void number_loop(const sph_lanes *in, int from, int to, double *sum,
                            sph_kernel_function shape, sph_kernel_function slope) {
  for (int i = from; i < to; i++) {
    row r = take_row(in, i);
    const vec per_h = vec_all(in->lens[2 * (size_t)i]);
    const vec own = vec_all(in->unit_norm) * slope_power(in, per_h);
    vec count = vec_all(0.0), moment = vec_all(0.0);
    for (; r.k < r.end; r.k += PART_WIDTH) {
      vec b[8], d[3], u[3];
      vec_load_8(in->xv, in->partner + r.k, b);
      const vec d2 = separate(&r, b, d, u), q = vec_sqrt(d2) * per_h;
      count += vec_keep(vec_less(vec_all(0.0), d2), own / (per_h * per_h) * shape(q));
      moment -= own * slope(q) * d2;
    }
    sum[SPH_SUMS * (size_t)i + 5] = vec_sum(count);
    sum[SPH_SUMS * (size_t)i + 6] = vec_sum(moment);
  }
}

/* S.8, S.9 and S.10 over V_i V_j and the slope of the pair whose length is h. */
PART_LANES void friction_of(const sph_lanes *in, const vec d[3], const vec u[3], vec d2, vec h,
                                vec eps, vec *along_d, vec *along_u) {
  const vec ratio = h * vec_all(1.0 / in->h), w = d[0] * u[0] + d[1] * u[1] + d[2] * u[2];
  *along_d = vec_all(0.0);
  *along_u = 2.0 * in->viscosity * eps;
  if (in->artificial > 0.0)
    *along_d += in->artificial * ratio * eps * vec_min(w, vec_all(0.0)) / (d2 + 0.01 * h * h);
  if (in->monaghan > 0.0) { /* its alpha is S mu/(rho c h) */
    const vec per_r = 1.0 / vec_sqrt(vec_max(d2, vec_all(1e-12 * in->h * in->h)));
    const vec speed = vec_max(w, -w) * per_r + in->sound_speed;
    *along_d += in->monaghan / ratio * eps * speed * w * per_r;
  }
}

/* Each with its own length and its own p/Omega, equal and opposite for each pair; viscosities with the mean of both
 * gradients, as Pi_ab in eq. 12 of Robinson et al. */
PART_LANES void variable_force_loop(const sph_lanes *in, int from, int to, double *sum,
                                    sph_kernel_function slope) {
  const vec norm = vec_all(in->unit_norm);
  for (int i = from; i < to; i++) {
    row r = take_row(in, i);
    const vec per_h = vec_all(in->lens[2 * (size_t)i]), own = norm * slope_power(in, per_h);
    const vec pa = r.p * vec_all(in->lens[2 * (size_t)i + 1]);
    const vec volume = vec_all(in->xv[SPH_XV * (size_t)i + 3]);
    vec s[3] = {vec_all(0.0), vec_all(0.0), vec_all(0.0)};
    for (; r.k < r.end; r.k += PART_WIDTH) {
      vec b[8], d[3], u[3], along_d, along_u, eps = r.eps;
      vec_load_8(in->xv, in->partner + r.k, b);
      const vec d2 = separate(&r, b, d, u), distance = vec_sqrt(d2);
      const vec per_hb = vec_load_1(in->lens, 2, in->partner + r.k);
      const vec pb = b[7] * vec_load_1(in->lens + 1, 2, in->partner + r.k);
      const vec fa = own * slope(distance * per_h);
      const vec fb = norm * slope_power(in, per_hb) * slope(distance * per_hb);
      if (in->porous)
        eps = 0.5 * (eps + vec_load_1(in->mass + 2, 4, in->partner + r.k));
      const vec h = 0.5 * (1.0 / per_h + 1.0 / per_hb);
      friction_of(in, d, u, d2, h, eps, &along_d, &along_u);
      const vec pressure = in->count ? pa * volume * fa + pb * (b[3] * b[3] / volume) * fb
                                     : b[3] * (pa * fa + pb * fb);
      const vec friction = 0.5 * b[3] * (fa + fb);
      for (int c = 0; c < 3; c++)
        s[c] += (friction * along_d - pressure) * d[c] + friction * along_u * u[c];
    }
    for (int c = 0; c < 3; c++)
      sum[SPH_SUMS * (size_t)i + (size_t)c] = vec_sum(s[c]);
  }
}
