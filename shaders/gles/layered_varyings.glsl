// Varyings from layered.vert to layered.frag: at most 15 vectors for 4 members of 6 layers. VARYING: in or out.
VARYING vec3 v_point;   // character's frame, metres
VARYING vec3 v_normal;
VARYING vec2 v_uv[MEMBERS];
VARYING vec4 v_masks[(MEMBERS * LAYERS + 3) / 4];  // seam masks, [drawn member][rank]
flat VARYING uint v_labels[MEMBERS];

const uint kEmpty = 31u;
