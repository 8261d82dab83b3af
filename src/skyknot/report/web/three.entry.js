// What the replay uses of three.js; esbuild leaves out the rest.
export {
  ACESFilmicToneMapping, BackSide, BoxGeometry, BufferAttribute, BufferGeometry, CanvasTexture,
  CircleGeometry, Color, ConeGeometry, CylinderGeometry, DirectionalLight, DoubleSide,
  EdgesGeometry, Float32BufferAttribute, Fog, Group, HemisphereLight, InstancedMesh, Line,
  LineBasicMaterial, LineDashedMaterial, LineSegments, MathUtils, Matrix4, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, MeshStandardMaterial, Object3D, PCFShadowMap,
  PerspectiveCamera, PlaneGeometry, Quaternion, RingGeometry, Scene, ShaderMaterial,
  ShadowMaterial, SphereGeometry, Sprite, SpriteMaterial, TorusGeometry, Vector2, Vector3,
  WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
export { Line2 } from "three/examples/jsm/lines/Line2.js";
export { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
export { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
