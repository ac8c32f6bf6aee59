// What layered.vert hands to layered.frag: at most 15 vectors for 4 sources of 6 layers. VARYING: in or out.
VARYING vec3 v_point;   // character's frame, metres
VARYING vec3 v_normal;
VARYING vec2 v_uv[SOURCES];
VARYING vec4 v_masks[(SOURCES * LAYERS + 3) / 4];  // seam masks, [source][slot]
flat VARYING uint v_labels[SOURCES];

const uint kEmpty = 31u;
