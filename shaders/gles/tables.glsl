// Index → texel of a table texture, TABLE_WIDTH texels a row (CharacterModel::kTableWidth).
ivec2 tableTexel(int index) { return ivec2(index % TABLE_WIDTH, index / TABLE_WIDTH); }
