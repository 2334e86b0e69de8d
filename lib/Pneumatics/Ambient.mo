within Pneumatics;
model Ambient "The surroundings"
  extends Source(p = Air.p_ambient);
end Ambient;
