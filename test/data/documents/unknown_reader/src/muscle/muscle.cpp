void read(const YamlNode& node) { node.number("force_n"); }
