// Index → texel of a table texture, TABLE_WIDTH texels per row (CharacterModel::kTableWidth).
ivec2 tableTexel(int index) { return ivec2(index % TABLE_WIDTH, index / TABLE_WIDTH); }
