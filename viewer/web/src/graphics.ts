// The context in which the page draws. Without a graphics card each sample of a pixel costs processor time, and making a
// context takes seconds, so that edges are smooth with a card only.
import {WebGLRenderer} from 'three';

const ATTRIBUTES = {alpha: false, depth: true, stencil: false, premultipliedAlpha: true, preserveDrawingBuffer: false};

function drawsInSoftware(context: WebGL2RenderingContext): boolean {
  const info = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export interface Graphics {
  renderer: WebGLRenderer;
  fast: boolean;  // by a graphics card
}

// `full`: with smooth edges in any case.
export function makeGraphics(full: boolean): Graphics {
  const canvas = document.createElement('canvas');
  const context = full ? null : canvas.getContext('webgl2', {...ATTRIBUTES, antialias: false});
  if (context && drawsInSoftware(context)) {
    return {renderer: new WebGLRenderer({canvas, context}), fast: false};
  }
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return {renderer: new WebGLRenderer({...ATTRIBUTES, antialias: true}), fast: true};
}
